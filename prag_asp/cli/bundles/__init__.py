"""Options that go together, each bundle as one value."""
