"""Pictures of witnesses and demonstrations."""
