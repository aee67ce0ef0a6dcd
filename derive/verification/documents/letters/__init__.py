"""The letters of a document: what it defines, and what the others can mean."""
