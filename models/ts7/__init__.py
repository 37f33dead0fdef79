"""TS-7, ATC equipment of the Sobu underground line (1972): three speed-check channels, synchronised and voted."""
