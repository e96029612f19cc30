"""Signatures in the formats of minisign 0.11, https://jedisct1.github.io/minisign/#signature-format."""
