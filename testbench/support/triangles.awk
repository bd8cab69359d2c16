# A scene of 155 triangles, a line of CSV each. Its upload has 52 + 155 * 36 = 5632 bytes: 11 packets of high speed, so that a
# zero-length packet has to end it.
BEGIN {
    OFS = ","
    for (i = 0; i < 155; i++) {
        x = i % 13
        y = int(i / 13)
        print x, y, i * 7 % 5, x + 1, y, i * 3 % 4, x, y + 1, i * 5 % 3
    }
}
