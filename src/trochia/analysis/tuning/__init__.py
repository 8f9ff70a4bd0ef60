"""From a model to gains: rules, pole placement, loop shaping, search; and what the gains are worth."""
