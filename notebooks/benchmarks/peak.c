/* Multiply-adds as fast as they go: twelve registers, more chains than one chain's latency. */

double peak(int64_t rounds)
{
    /* no two alike, or a compiler computes them once */
    half a = {0.1}, b = {0.2}, c = {0.4}, d = {0.8}, e = {1.6}, f = {3.2};
    half g = {0.3}, h = {0.6}, i = {1.2}, j = {2.4}, k = {4.8}, l = {9.6};
    const half factor = {0.5, 0.5}, term = {1e-9};
    for (int64_t round = 0; round < rounds; round++) {
        a = a*factor + term;
        b = b*factor + term;
        c = c*factor + term;
        d = d*factor + term;
        e = e*factor + term;
        f = f*factor + term;
        g = g*factor + term;
        h = h*factor + term;
        i = i*factor + term;
        j = j*factor + term;
        k = k*factor + term;
        l = l*factor + term;
    }
    a += b + c + d + e + f + g + h + i + j + k + l;
    return a[0];
}

/* Operations of a round. */
int64_t operations(void)
{
    return 12*2*(LANES/2);
}
