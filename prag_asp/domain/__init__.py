"""Load a domain from files and check it, or write a new domain as a starting point."""
