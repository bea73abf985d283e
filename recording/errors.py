"""The one error that a user's input can raise."""


class InputError(ValueError):
    """The input or the arguments are wrong: one sentence with what was expected, what came, what to do.

    It is raised once, at the boundary, and the command line turns it into one line on standard error
    and exit status 2.
    """
