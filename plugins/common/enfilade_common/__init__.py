"""What every Enfilade plugin shares: the study as a model, its files, its results, the program.

Pure Python 3.8+, standard library only, no host program is imported here. Lengths are millimetres in the
drawing frame (x east, y north) unless a name says otherwise; angles are degrees, anticlockwise.
"""

__version__ = "0.1.0"

#: Name under which our extended data (XDATA) stands in a DXF.
APPLICATION = "ENFILADE"
