/* What the FMU says: one sentence per error, numbers with a decimal point in every locale. */

static const char *number(char *buffer, size_t size, double value)
{
    char *c;
    if (value != value)
        snprintf(buffer, size, "nan"); /* some C libraries print the sign of a NaN */
    else
        snprintf(buffer, size, "%.9g", value);
    for (c = buffer; *c; c++)
        if (*c == ',')
            *c = '.';
    return buffer;
}

static Status report(Instance *in, Status status, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(in->message, sizeof in->message, format, arguments);
    va_end(arguments);
    if (in->send)
        in->send(in, status, in->message);
    if (status >= STATUS_ERROR)
        in->mode = FAILED;
    return status;
}
