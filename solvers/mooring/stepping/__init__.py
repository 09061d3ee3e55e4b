"""Moving lines over time: the steps of generalized-alpha, the integration, and its histories."""
