"""Report: a result as one page of HTML with an animated stage view, figures and tables; it needs no network."""
