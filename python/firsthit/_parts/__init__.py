"""Parts of a job in a folder: whole or not there, each with the digest of what it holds."""
