"""One hair strand in several rod codes, for tests/bench/peers.py."""
