"""Makes the claims and campaigns of a project's proofs/ test items of pytest."""
