"""Signatures in the formats of minisign: its keys, its signature files, what a table's says.

    key_pair ──> secret_key ──> sign ──> FILE.minisig
                 public_key ──> verify <──┘   signature
                                  └──> statement (which table, state and journal)

The formats are those of minisign 0.11, https://jedisct1.github.io/minisign/#signature-format.
"""
