"""What every folder may use: errors, arguments to arrays, progress. It knows no scene."""
