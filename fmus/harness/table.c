/* Tables: read from their text "a b c;d e f", looked up by their first, ascending column. */

/* Read one number; the text is not NUL-terminated.  Returns 0 if it is none.  strtod expects the locale's own decimal
 * point, so it is given that. */
static int read_number(const char *from, const char *to, double *value)
{
    char copy[64], *end;
    const char *point = localeconv()->decimal_point;
    size_t n = 0, point_length = strlen(point);
    for (; from < to; from++) {
        if (n + point_length + 1 > sizeof copy || !strchr("0123456789+-.eE", *from))
            return 0;
        if (*from == '.') {
            memcpy(copy + n, point, point_length);
            n += point_length;
        } else {
            copy[n++] = *from;
        }
    }
    copy[n] = '\0';
    *value = strtod(copy, &end);
    return n > 0 && *end == '\0' && *value - *value == 0;
}

static int is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

/* Count the numbers of a text: an upper bound for what has to be allocated. */
static size_t count_numbers(const char *text)
{
    size_t n = 0;
    int inside = 0;
    for (; *text; text++) {
        int separator = is_blank(*text) || *text == ';';
        n += !separator && !inside;
        inside = !separator;
    }
    return n;
}

/* Fill *rows* from the text; returns the number of rows, or -1 after reporting what is wrong. */
static int read_rows(Instance *in, const TableLayout *layout, const char *text, double *rows)
{
    int n_rows = 0, n = 0;
    double *next = rows;
    for (;; text++) {
        if (*text == ';' || *text == '\0') {
            if (n && n != layout->columns) {
                report(in, STATUS_ERROR, "table %s: row %d has %d numbers, but needs %d", layout->name, n_rows + 1, n, layout->columns);
                return -1;
            }
            if (n && n_rows && !(next[-n] > next[-n - layout->columns])) {
                report(in, STATUS_ERROR, "table %s: row %d does not ascend in its first column, by which rows are looked up", layout->name, n_rows + 1);
                return -1;
            }
            n_rows += n > 0;
            n = 0;
            if (*text == '\0')
                return n_rows;
        } else if (!is_blank(*text)) {
            const char *from = text;
            while (text[1] && text[1] != ';' && !is_blank(text[1]))
                text++;
            if (!read_number(from, text + 1, next)) {
                report(in, STATUS_ERROR, "table %s: row %d holds '%.*s', which is not a finite number", layout->name, n_rows + 1,
                       (int)(text + 1 - from < 40 ? text + 1 - from : 40), from);
                return -1;
            }
            next++;
            n++;
        }
    }
}

/* FNV-1a over the numbers of all tables: a snapshot can tell whether it belongs to them. */
static uint64_t hash_tables(const Instance *in)
{
    uint64_t hash = 14695981039346656037u;
    int i;
    size_t b;
    for (i = 0; i < model.n_tables; i++) {
        const unsigned char *bytes = (const unsigned char *)in->tables[i].rows;
        for (b = 0; b < sizeof(double) * (size_t)in->tables[i].n_rows * (size_t)model.tables[i].columns; b++)
            hash = (hash ^ bytes[b]) * 1099511628211u;
    }
    return hash;
}

static Status table_set(Instance *in, int table, const char *text)
{
    const TableLayout *layout = &model.tables[table];
    Table *target = &in->tables[table];
    size_t n = count_numbers(text), length = strlen(text) + 1;
    double *rows = malloc((n ? n : 1) * sizeof *rows);
    char *copy = malloc(length);
    int i, n_rows = -1;
    if (!rows || !copy)
        report(in, STATUS_ERROR, "table %s: out of memory for %lu numbers", layout->name, (unsigned long)n);
    else if ((n_rows = read_rows(in, layout, text, rows)) == 0) {
        report(in, STATUS_ERROR, "table %s is empty: it needs at least one row of %d numbers", layout->name, layout->columns);
        n_rows = -1;
    }
    if (n_rows < 0) {
        free(rows);
        free(copy);
        return STATUS_ERROR;
    }
    free(target->text);
    free(target->rows);
    target->text = memcpy(copy, text, length);
    target->rows = rows;
    target->n_rows = n_rows;
    in->tables_hash = hash_tables(in);
    in->outputs_valid = in->derivatives_valid = in->signs_known = 0;
    for (i = 0; i < model.n_keys; i++)
        in->hint[i] = -1;
    return STATUS_OK;
}

/* The last row whose key is not above *key*, the first row if all are; a NaN finds the last row. */
static int find_row(const double *rows, int n_rows, int columns, double key, int hint)
{
    int low = 0, high = n_rows;
    if (hint >= 0 && !(key < rows[hint * columns]) && (hint + 1 == n_rows || key < rows[(hint + 1) * columns]))
        return hint;
    while (high - low > 1) {
        int middle = low + (high - low) / 2;
        if (key < rows[middle * columns])
            high = middle;
        else
            low = middle;
    }
    return low;
}

/* Look up every row by in->keys; what stands there since the last time stays. */
static void table_rows(Instance *in)
{
    int i, j, key = 0;
    double *target = in->rows;
    for (i = 0; i < model.n_tables; i++) {
        const Table *table = &in->tables[i];
        int columns = model.tables[i].columns;
        for (j = 0; j < model.tables[i].keys; j++, key++, target += columns) {
            int row = find_row(table->rows, table->n_rows, columns, in->keys[key], in->hint[key]);
            if (row != in->hint[key])
                memcpy(target, table->rows + row * columns, sizeof *target * (size_t)columns);
            in->hint[key] = row;
        }
    }
}
