"""How an estimate begins: from field and Sun in one tick, or from a batch of field and cells."""
