"""The bus contract: frames, messages and their CRC."""
