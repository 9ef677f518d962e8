"""Questions that rules ask and nobody else: rolling elements, captive parts, motions through intermediate bodies."""
