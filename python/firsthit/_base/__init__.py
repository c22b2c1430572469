"""What every folder may use: types, errors, arguments to arrays, progress. It knows no scene."""
