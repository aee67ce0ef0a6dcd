"""Studies of methods: work-precision, stability, failure modes and benchmarks."""
