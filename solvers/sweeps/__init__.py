"""Maps of very many motions: what varies, what is kept of each, and how they are shared out."""
