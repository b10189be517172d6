"""The keys of scenario files for those who write them: a page, and a schema for editors."""
