"""What is wrong with recordings besides physics: blunders, heavy tails, more noise than stated, noise that wanders, columns
exchanged or of the wrong sign. Noise is the difference of two simulations, so it is right for every kind of instrument."""


def columns_of(clean, noisy):
    """Which columns have noise: readings and measurements."""
    return [i for i in range(len(clean[0])) if any(a[i] != b[i] for a, b in zip(clean[1], noisy[1]))]


def wandering(clean, noisy, draw):
    """Noise correlated in time, of the stated size."""
    rho = draw.uniform(0.6, 0.95)
    columns, now, rows = columns_of(clean, noisy), {}, []
    for k, (a, b) in enumerate(zip(clean[1], noisy[1])):
        row = list(a)
        for i in columns:
            if not a[i] or not b[i]:
                continue
            e = float(b[i]) - float(a[i])
            now[i] = e if k == 0 else rho * now.get(i, 0) + (1 - rho * rho) ** 0.5 * e
            row[i] = f"{float(a[i]) + now[i]:.9g}"
        rows.append(row)
    return (clean[0], rows), f"correlation {rho:.2f} of neighbours"


def mixed(noisy, wild, share, draw):
    """Some rows from recordings with more noise; which ones."""
    count = len(noisy[1])
    bad = sorted(draw.sample(range(count), share if isinstance(share, int) else max(1, round(share * count))))
    rows = [list(r) for r in noisy[1]]
    for k in bad:
        rows[k] = list(wild[1][k])
    return (noisy[0], rows), bad


def wrong_column(noisy, names, draw):
    """Two columns exchanged, or one of the wrong sign. `names`: columns that may be concerned."""
    rows = [list(r) for r in noisy[1]]
    at = {n: noisy[0].index(n) for n in names}
    first = draw.choice(names)
    same = [n for n in names if n != first and n.split("[")[1:] == first.split("[")[1:]]
    if same and draw.random() < 0.5:
        second = draw.choice(same)
        for r in rows:
            r[at[first]], r[at[second]] = r[at[second]], r[at[first]]
        return (noisy[0], rows), "swapped-columns", [first, second]
    for r in rows:
        r[at[first]] = f"{-float(r[at[first]]):.9g}"
    return (noisy[0], rows), "wrong-sign", [first]
