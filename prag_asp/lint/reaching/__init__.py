"""What may ever be so, if nothing that may have been so is ever lost."""
