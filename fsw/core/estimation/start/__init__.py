"""How an estimate begins: by field and Sun in one tick, or by a batch of field and cells."""
