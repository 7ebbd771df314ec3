"""Closed surfaces of scanned clouds, for palpate-mesh scan."""
