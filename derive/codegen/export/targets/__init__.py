"""Target languages of exports: one file each, with a `Target` called ``target``."""
