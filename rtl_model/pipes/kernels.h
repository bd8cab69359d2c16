/* The loops around one pipe in wide lanes. No include guard: wide_pipe.h includes it for each way of underflow, with
 * HP_PIPE set.
 *
 * Lanes are primaries in `closest` and `any`: a chunk of primaries stays in registers (or the first-level cache)
 * while the prepared secondaries stream by, each word broadcast. Lanes are pairs in `pairs`, and secondaries in
 * `prepare`. */

#define HP_OF(function) HP_NAMED(HP_PASTE(HP_PIPE, function))
#define HP_WORDS(object) HP_PASTE(HP_PIPE, object)

/* Transforms, where there is a matrix, and prepares a chunk of secondaries. */
HP_INLINE void HP_OF(prepare_lanes)(bool moves, const num *m, const num *secondary, num *prepared) {
    num moved[HP_OBJECT_WORDS_MAX];
    if (moves) {
        HP_OF(transform)(m, secondary, moved);
        HP_OF(prepare)(moved, prepared);
    } else {
        HP_OF(prepare)(secondary, prepared);
    }
}

HP_APART void HP_OF(prepares)(const float *secondaries, size_t n, const float *matrix, float *prepared) {
    num m[12], secondary[HP_OBJECT_WORDS_MAX], ready[HP_PREPARED_MAX];
    bool moves = HP_NAMED(load_matrix)(matrix, m);
    for (size_t i = 0; i < n; i += HP_CHUNK) {
        size_t lanes = n - i < HP_CHUNK ? n - i : HP_CHUNK;
        HP_NAMED(gather)
        (secondaries + i * HP_WORDS(secondary_words), HP_WORDS(secondary_words), HP_WORDS(secondary_words), lanes,
         secondary);
        HP_OF(prepare_lanes)(moves, m, secondary, ready);
        HP_NAMED(scatter)(ready, HP_WORDS(prepared_words), lanes, prepared + i * HP_WORDS(prepared_words));
    }
}

/* What closer means: ray pairs keep the smallest T, the others the deepest. */
HP_INLINE flag HP_OF(closer)(num T, num best_T) {
    return HP_WORDS(keeps_deepest) ? less(best_T, T) : less(T, best_T);
}

/* The chunk of primaries at `primary`: lanes of word 0; the next word is HP_PACKET_PRIMARIES floats on. */
HP_INLINE void HP_OF(load_chunk)(const float *primary, num *p) {
    foreach (w, HP_WORDS(primary_words)) p[w] = HP_NAMED(load)(primary + w * HP_PACKET_PRIMARIES);
}

HP_INLINE void HP_OF(closest_one)(const num *p, const num *s, bits index, float *best_T, uint32_t *best_index) {
    num T = HP_NAMED(reload)(best_T);
    answer a = HP_OF(test)(p, s, index, false, T);
    if (!a.any) return;
    flag closer = and(a.F, HP_OF(closer)(a.T, T));
    HP_NAMED(store)(best_T, select(closer, a.T, T));
    HP_NAMED(store_bits)(best_index, select_bits(closer, a.index, HP_NAMED(load_bits)(best_index)));
}

/* What one chunk of primaries keeps of n prepared secondaries. */
HP_APART void HP_OF(closest_chunk)(const float *primary, const float *prepared, size_t n, uint32_t index,
                                   float *best_T, uint32_t *best_index, uint32_t *best_F) {
    num p[HP_OBJECT_WORDS_MAX];
    (void)best_F;
    HP_OF(load_chunk)(primary, p);
    for (size_t i = 0; i < n; i++) {
        num s[HP_PREPARED_MAX];
        HP_NAMED(broadcast)(prepared + i * HP_WORDS(prepared_words), HP_WORDS(prepared_words), s);
        HP_OF(closest_one)(p, s, constant_bits(index + (uint32_t)i), best_T, best_index);
    }
}

/* Stops when every lane has a hit. */
HP_APART void HP_OF(any_chunk)(const float *primary, const float *prepared, size_t n, uint32_t index, float *best_T,
                               uint32_t *best_index, uint32_t *best_F) {
    num p[HP_OBJECT_WORDS_MAX];
    (void)best_F;
    HP_OF(load_chunk)(primary, p);
    bits none = constant_bits(HP_NO_INDEX);
    flag open = HP_NAMED(same_bits)(HP_NAMED(load_bits)(best_index), none);
    for (size_t i = 0; i < n && HP_NAMED(any)(open); i++) {
        num s[HP_PREPARED_MAX];
        HP_NAMED(broadcast)(prepared + i * HP_WORDS(prepared_words), HP_WORDS(prepared_words), s);
        num bar = select(open, constant(-INFINITY), constant(INFINITY));
        answer a = HP_OF(test)(p, s, constant_bits(index + (uint32_t)i), false, bar);
        if (!a.any) continue;
        flag first = and(a.F, open);
        bits found = select_bits(first, a.index, HP_NAMED(load_bits)(best_index));
        HP_NAMED(store)(best_T, select(first, a.T, HP_NAMED(reload)(best_T)));
        HP_NAMED(store_bits)(best_index, found);
        open = HP_NAMED(same_bits)(found, none);
    }
}

HP_INLINE void HP_OF(nearest_one)(const num *p, const num *s, bits index, float *best_T, uint32_t *best_index,
                                  uint32_t *best_F) {
    bits one = constant_bits(1);
    answer a = HP_OF(test)(p, s, index, true, constant(-INFINITY));
    if (!a.any) return;
    num T = HP_NAMED(reload)(best_T);
    bits F_bits = HP_NAMED(load_bits)(best_F);
    flag F = HP_NAMED(same_bits)(F_bits, one);
    flag first_hit = and(a.F, not(F));
    flag closer_hit = and(and(a.F, F), HP_OF(closer)(a.T, T));
    flag closer_miss = and(not(or (a.F, F)), less(a.T, T));
    flag closer = or (or (first_hit, closer_hit), closer_miss);
    HP_NAMED(store)(best_T, select(closer, a.T, T));
    HP_NAMED(store_bits)(best_index, select_bits(closer, index, HP_NAMED(load_bits)(best_index)));
    HP_NAMED(store_bits)(best_F, select_bits(first_hit, one, F_bits));
}

/* As closest_chunk, but a primary without a hit keeps the nearest miss. */
HP_APART void HP_OF(nearest_chunk)(const float *primary, const float *prepared, size_t n, uint32_t index,
                                   float *best_T, uint32_t *best_index, uint32_t *best_F) {
    num p[HP_OBJECT_WORDS_MAX];
    HP_OF(load_chunk)(primary, p);
    for (size_t i = 0; i < n; i++) {
        num s[HP_PREPARED_MAX];
        HP_NAMED(broadcast)(prepared + i * HP_WORDS(prepared_words), HP_WORDS(prepared_words), s);
        HP_OF(nearest_one)(p, s, constant_bits(index + (uint32_t)i), best_T, best_index, best_F);
    }
}

/* Primaries [from, to) chunk by chunk. A last chunk that is not full is worked on in a copy, with done and zero lanes
 * behind it: another thread may own the primaries from `to` on. */
HP_INLINE void HP_OF(each_chunk)(hp_chunk_kernel *kernel, const hp_lanes *lanes, unsigned from, unsigned to,
                                 const float *prepared, size_t n, uint32_t index, hp_best *best) {
    for (; from + HP_CHUNK <= to; from += HP_CHUNK)
        kernel(&lanes->word[0][from], prepared, n, index, &best->T[from], &best->index[from], &best->F[from]);
    if (from >= to) return;
    hp_lanes rest;
    hp_best kept;
    size_t bytes = (to - from) * sizeof(float);
    for (unsigned w = 0; w < HP_WORDS(primary_words); w++) {
        memset(rest.word[w], 0, HP_CHUNK * sizeof(float));
        memcpy(rest.word[w], &lanes->word[w][from], bytes);
    }
    memset(kept.index, 0, HP_CHUNK * sizeof(uint32_t));
    memset(kept.T, 0, HP_CHUNK * sizeof(float));
    memset(kept.F, 0, HP_CHUNK * sizeof(uint32_t));
    memcpy(kept.index, &best->index[from], bytes);
    memcpy(kept.T, &best->T[from], bytes);
    memcpy(kept.F, &best->F[from], bytes);
    kernel(rest.word[0], prepared, n, index, kept.T, kept.index, kept.F);
    memcpy(&best->index[from], kept.index, bytes);
    memcpy(&best->T[from], kept.T, bytes);
    memcpy(&best->F[from], kept.F, bytes);
}

HP_INLINE void HP_OF(each_pair)(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,
                                const float *matrix, bool separation, const hp_pairs_out *out) {
    num m[12], primary[HP_OBJECT_WORDS_MAX], secondary[HP_OBJECT_WORDS_MAX], ready[HP_PREPARED_MAX];
    bool moves = HP_NAMED(load_matrix)(matrix, m);
    size_t step = primary_step * HP_WORDS(primary_words);
    HP_NAMED(gather)(primaries, 0, HP_WORDS(primary_words), 1, primary);
    for (size_t i = 0; i < n; i += HP_CHUNK) {
        size_t lanes = n - i < HP_CHUNK ? n - i : HP_CHUNK;
        if (step) HP_NAMED(gather)(primaries + i * step, step, HP_WORDS(primary_words), lanes, primary);
        HP_NAMED(gather)
        (secondaries + i * HP_WORDS(secondary_words), HP_WORDS(secondary_words), HP_WORDS(secondary_words), lanes,
         secondary);
        HP_OF(prepare_lanes)(moves, m, secondary, ready);
        HP_NAMED(write_pairs)
        (HP_OF(test)(primary, ready, constant_bits(0), separation, constant(-INFINITY)), lanes, i, out);
    }
}

HP_APART void HP_OF(pairs)(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,
                           const float *matrix, const hp_pairs_out *out) {
    HP_OF(each_pair)(primaries, primary_step, secondaries, n, matrix, false, out);
}

HP_APART void HP_OF(distances)(const float *primaries, unsigned primary_step, const float *secondaries, size_t n,
                               const float *matrix, const hp_pairs_out *out) {
    HP_OF(each_pair)(primaries, primary_step, secondaries, n, matrix, true, out);
}

#define HP_KEEPING(kept)                                                                                             \
    HP_APART void HP_OF(kept)(const hp_lanes *lanes, unsigned from, unsigned to, const float *prepared, size_t n,    \
                              uint32_t index, hp_best *best) {                                                       \
        HP_OF(each_chunk)(HP_OF(kept##_chunk), lanes, from, to, prepared, n, index, best);                           \
    }
HP_KEEPING(closest)
HP_KEEPING(any)
HP_KEEPING(nearest)
#undef HP_KEEPING

#undef HP_OF
#undef HP_WORDS
