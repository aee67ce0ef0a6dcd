"""Studies of methods: work-precision, stability and failure modes."""
