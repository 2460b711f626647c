"""Load a domain from files and check it; write a new domain as a starting point."""
