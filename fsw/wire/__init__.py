"""The bus contract: frames, messages, CRC. The only part of fsw that other packages import."""
