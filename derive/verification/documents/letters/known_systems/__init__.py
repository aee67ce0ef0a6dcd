"""Systems that are known from elsewhere, in one file for each use."""
