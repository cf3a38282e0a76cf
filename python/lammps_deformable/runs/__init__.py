"""Folders of results: record, resume, replay, movie."""
