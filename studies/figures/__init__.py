"""Every figure and table of the thesis and its papers that can be computed, and the verdict on what they claim."""
