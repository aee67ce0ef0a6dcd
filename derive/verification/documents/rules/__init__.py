"""What each kind of statement must equal, and the wrong term where it does not."""
