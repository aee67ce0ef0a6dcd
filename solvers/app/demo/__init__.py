"""The whole way on one page: what ``holonomic demo`` does, measures and shows."""
