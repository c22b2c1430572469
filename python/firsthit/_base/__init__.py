"""The ground of all folders: errors, arguments to arrays, progress. It knows no scene."""
