"""The names of frames in the folder of a data set."""

from firsthit._parts._part import Form

FORM = Form("frames", "frame.json", "plan")
