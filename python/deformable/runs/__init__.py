"""What happens to a folder of results: record, resume, replay, movie."""
