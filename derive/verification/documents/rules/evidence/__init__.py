"""Which verdicts stand by the evidence of a document."""
