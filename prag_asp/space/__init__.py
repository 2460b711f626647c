"""Task spaces: counted, enumerated, drawn."""
