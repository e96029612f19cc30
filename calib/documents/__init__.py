"""What the documents of the project may contain: TOML and JSON, their schemas and mistakes."""
