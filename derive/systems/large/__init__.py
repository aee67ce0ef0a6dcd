"""Systems whose modules are too long to ship: each is derived when it is first used."""
