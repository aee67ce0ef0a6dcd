"""Speed against accuracy: what each method, form and backend costs for an error."""
