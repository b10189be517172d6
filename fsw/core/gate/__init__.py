"""Which frames are accepted: intact ones, of a believed tick, from one sender of each message."""
