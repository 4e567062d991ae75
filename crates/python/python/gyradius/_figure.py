"""The triangle of second moments: which draws some body has, at a glance."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SIDE = 330.0
HEAD = 52.0
"""Height above each panel, in which its title and the number of impossible draws stand."""
MOST = 600
"""Points of a panel: what more would not show."""
CORNERS = np.array([[0.5, 0.0], [0.0, 0.75**0.5], [1.0, 0.75**0.5]])
"""Where all matter lies on the first, second or third principal axis: rods. Flat plates are on the sides, a ball is the middle."""
GOOD, BAD, INK, FAINT = "#0072b2", "#d1242f", "#222222", "#8b949e"


def second_moments(inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shares (n, 3) of the second moments about the principal axes in their sum."""
    from gyradius._inertia import principal_axes

    moments = principal_axes(inertia.reshape(-1, 3, 3)).moments
    k = 0.5 * moments.sum(axis=1, keepdims=True) - moments
    total = k.sum(axis=1, keepdims=True)
    return np.divide(k, total, out=np.full_like(k, 1 / 3), where=total > 0)


def triangle(panels: Sequence[tuple[str, Any]], title: str) -> str:
    """Draws of inertias (n, 3, 3), or of bodies, as points in the triangle of bodies, red what no body has; a panel for each of them, side
    by side. What is not finite has no place there, and counts."""
    drawn = [_shares(some) for _, some in panels]
    low, size = _window(np.concatenate([shares for shares, _ in drawn]) @ CORNERS)
    width = len(panels) * (SIDE + 24) + 16
    height = HEAD + SIDE + 40
    said = "; ".join(f"{name}: {_impossible(bad)}" for (name, _), (_, bad) in zip(panels, drawn))
    parts = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" role="img" '
        'style="max-width:100%;height:auto" font-family="\'Helvetica Neue\',Helvetica,Arial,sans-serif">',
        f"<title>{html.escape(title)}</title>",
        f"<desc>{html.escape(said)}</desc>",
        f'<rect width="{width:.0f}" height="{height:.0f}" fill="#ffffff"/>',
    ]
    for place, ((name, _), (shares, bad)) in enumerate(zip(panels, drawn)):
        parts.append(_panel(16 + place * (SIDE + 24), name, shares, bad, low, size))
    foot = "Each point is a draw: the shares of its second moments. Flat bodies are on the sides, rods in the corners, a ball in the middle."
    words = foot if len(panels) > 1 else "Flat bodies are on the sides, rods in the corners."
    parts.append(_text(16, height - 12, words, 11, FAINT))
    return "\n".join([*parts, "</svg>"]) + "\n"


def _window(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """The corner and the side of the square that is shown: the whole triangle, or the part of it where the draws are."""
    inside = points[np.isfinite(points).all(axis=1)]
    if not len(inside):
        return np.array([-0.04, -0.1]), 1.08
    low, high = np.quantile(inside, 0.005, axis=0), np.quantile(inside, 0.995, axis=0)
    size = float(max(1.5 * (high - low).max(), 0.12))
    if size > 0.6:
        return np.array([-0.04, -0.1]), 1.08
    return 0.5 * (low + high) - 0.5 * size, size


def _shares(drawn: Any) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The shares (n, 3) of the second moments in their sum, NaN of what is not finite, and which of the draws no body has."""
    inertia = np.asarray(getattr(drawn, "inertia", drawn), dtype=float).reshape(-1, 3, 3)
    # Bodies have a mass and a place, too.
    ten = np.asarray(getattr(drawn, "array", np.ones(10))).reshape(-1, 10)
    shares = np.full((len(inertia), 3), np.nan)
    finite = np.isfinite(inertia).all(axis=(1, 2))
    shares[finite] = second_moments(inertia[finite])
    return shares, ~((shares.min(axis=1) >= -1e-9) & (ten[:, 0] > 0) & np.isfinite(ten).all(axis=1))


def _panel(
    left: float, name: str, shares: NDArray[np.float64], bad: NDArray[np.bool_], low: NDArray[np.float64], size: float
) -> str:
    scale = SIDE / size

    def at(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return (points - low) * scale

    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in at(CORNERS))
    share = _impossible(bad)
    parts = [
        _text(left, 20, name, 14, INK, bold=True),
        _text(left, 40, share, 13, BAD if bad.any() else GOOD),
        f'<svg x="{left:.0f}" y="{HEAD:.0f}" width="{SIDE:.0f}" height="{SIDE:.0f}" viewBox="0 0 {SIDE:.0f} {SIDE:.0f}">',
        f'<rect width="{SIDE:.0f}" height="{SIDE:.0f}" fill="#f6f8fa"/>',
        f'<polygon points="{corners}" fill="#ffffff" stroke="{INK}" stroke-width="1.2"/>',
    ]
    shown = slice(0, MOST)
    for which, colour in ((~bad[shown], GOOD), (bad[shown], BAD)):
        points = at(shares[shown][which] @ CORNERS)
        # A line of no length with round ends is a point, and all of them are one path.
        path = "".join(f"M{x:.1f} {y:.1f}h0" for x, y in points if np.isfinite(x + y))
        if path:
            parts.append(
                f'<path d="{path}" stroke="{colour}" stroke-width="4" stroke-linecap="round" stroke-opacity="0.6"/>'
            )
    return "\n".join([*parts, _key(low, size), "</svg>"])


def _key(low: NDArray[np.float64], size: float) -> str:
    """Where in the triangle the window lies, if it is a part of it."""
    if size > 1.0:
        return ""
    small = 56.0
    corners = " ".join(f"{x:.1f},{y:.1f}" for x, y in CORNERS * small)
    x, y = low * small
    side = size * small
    return (
        f'<g transform="translate({SIDE - small - 10:.0f} 10)"><polygon points="{corners}" fill="none" stroke="{FAINT}"/>'
        f'<rect x="{x:.1f}" y="{y:.1f}" width="{side:.1f}" height="{side:.1f}" fill="none" stroke="{INK}"/></g>'
    )


def _impossible(bad: NDArray[np.bool_]) -> str:
    draws, few = len(bad), int(bad.sum())
    percent = round(100 * few / max(draws, 1))
    # None and all are said of none and of all alone.
    is_rounded_away = (percent == 0 and few > 0) or (percent == 100 and few < draws)
    return f"{few if is_rounded_away else f'{percent} %'} of {draws} draws {'belongs' if is_rounded_away and few == 1 else 'belong'} to no body"


def _text(x: float, y: float, words: str, size: float, colour: str, *, bold: bool = False) -> str:
    weight = ' font-weight="600"' if bold else ""
    return f'<text x="{x:.0f}" y="{y:.0f}" font-size="{size:g}" fill="{colour}"{weight}>{html.escape(words)}</text>'
